"""User interface: `panels` in the sidebar, `menus`, the `overlay`, the add-on's `preferences`, and `manual`, the F1
pages."""
