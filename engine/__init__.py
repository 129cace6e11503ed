"""Methods for editing facial performances: numpy, scipy and torch, no window and no renderer.

What all share
    `take`, `character`, `controls` (distances on the face), `extended` (six more), `pose`, `anatomy`, `easing`, `errors`;
    `jaw` (lips close no further than it has opened), `mesh` (what hangs together), `assets` (where files of ours lie).
What the user asks for
    `editing` is the front door: a request and a function for each verb; it composes the methods below. `patch` is what
    an edit comes to, `retouch` edits weights without a network,
    `exact` lands on asked distances, `quality` flags frames to look at.
Methods, none of which knows another
    `regress` (curves to a face), `inpaint` (spans), `clean` (tracker noise), `spacetime` (pins, markers and heads by
    movement), `manifold` (heads by labelled frames, meshes by a few points); `models` is what their networks share.
In and out
    `formats` reads and writes files (`livelink`, `markers` and `characters` each a package, `base` under all),
    `project` is the `.retake` file, `live` hears a phone, `speech` knows phones and visemes.
What trains, measures and builds: `lab`, which nothing that ships imports
    `modelling` makes the bundled head, `performer` performs for training and tests, `corpus` finds recorded takes,
    `train` has a package per method and one loop for all, `trainings` lists them; `evaluate` compares with baselines, a
    package per method, `evaluate.tables` lists the tables; `speed` measures.
"""
