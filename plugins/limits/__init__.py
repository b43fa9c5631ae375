"""Limits of joints that are no ranges of heading, pitch and bank."""
