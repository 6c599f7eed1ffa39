"""The user's settings.

`settings`: the properties, of the scene and of the operator. `level_list`: the levels as a list. `groups`: settings
shown together. `conversion`: from settings to the parameters of other modules.
"""
