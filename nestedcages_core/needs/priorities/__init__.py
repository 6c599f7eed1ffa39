"""Where vertices matter: weights, pins, joints and limits."""
