"""The leg of source 002: six hinges from hip to ankle in closed form."""
