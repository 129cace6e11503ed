"""Methods for editing facial performances: numpy, scipy and torch, no window and no renderer.

What all share
    `take`, `character`, `controls` (distances on the face), `extended` (six more), `pose`, `anatomy`, `easing`, `errors`.
What the user asks for
    `editing` is the front door: a request and a function for each verb; it composes the methods below. `patch` is what
    an edit comes to, `retouch` edits weights without a network,
    `exact` lands on asked distances, `quality` flags frames to look at.
Methods, none of which knows another
    `regress` (curves to a face), `inpaint` (spans), `clean` (tracker noise), `spacetime` (pins, markers and heads by
    movement), `manifold` (heads by labelled frames, meshes by a few points); `models` is what their networks share.
In and out
    `formats` reads and writes files, `project` is the `.retake` file, `live` hears a phone, `speech` knows phones and
    visemes.
Beside the work
    `modelling` makes the bundled head, `performance` performs for training and tests, `corpus` finds recorded takes,
    `evaluate` compares with baselines, `speed` measures.
"""
