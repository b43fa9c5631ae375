"""Experiments: strategies x options x chains x goals, solved in batches, kept as a table."""
