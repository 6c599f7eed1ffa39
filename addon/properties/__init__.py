"""What the user can set.

`settings`: the properties, of the scene and of the operator. `level_list`: the levels one by one. `groups`: what is
shown together. `conversion`: settings to what other rooms take.
"""
