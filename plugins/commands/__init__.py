"""The commands of `limbik`, one a file: read, call, print."""
