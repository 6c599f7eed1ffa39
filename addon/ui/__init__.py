"""What users see besides operators: `panels` in the sidebar, the add-on's `preferences`, and `manual`, the F1 pages."""
