"""Steps as shape keys and keyframes, objects hidden until their time, and all of it baked into one action."""
