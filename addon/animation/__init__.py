"""Steps as shape keys and keyframes.

`timeline`: frames of phases and steps, markers, the scene's last frame. `shape_keys`: steps as keys and F-curves.
`visibility`: objects hidden until a frame. `stage`: the moving copy in place of the originals.
`playing`: whether there is an animation, and its removal.
"""
