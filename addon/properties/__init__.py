"""What the user can set: `settings` of the scene and the operator, and `level_list`, their levels one by one."""
