"""The viewer: drag a chain's goal in the browser and see what the solver makes of it (L-06).

`setup` and `session` are the model: plain values in limbik's own axes, no browser. `shapes`, `arcs`
and `views` say what is to be drawn. The rest speaks to viser, which runs the page; `axes` is the
one place where coordinates change hands.
"""
