"""Root controls: limits that hold for one solve only."""
