"""The minimum every solve needs: chain, stages, hooks, registry, scenes."""
