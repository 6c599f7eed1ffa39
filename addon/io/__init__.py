"""Import of files and images, export: `importers`, `exporters`, `pieces`, `pictures`, `silhouette`."""
