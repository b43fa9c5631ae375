"""What every test shares: how hypothesis searches.

The profile `repeatable` is the default, so that a red run is red again. With
`HYPOTHESIS_PROFILE=explore` it looks at new examples, ten times as many.
"""

import os

from hypothesis import settings

settings.register_profile(
    "repeatable", derandomize=True, database=None, deadline=None, print_blob=True
)
settings.register_profile(
    "explore", database=None, deadline=None, print_blob=True, max_examples=1000
)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))
