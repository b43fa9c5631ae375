"""What the command line puts out: tables, records for machines, pictures, failures."""
