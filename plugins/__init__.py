"""Built-in plug-ins, registered through the same hooks as those of third parties."""
