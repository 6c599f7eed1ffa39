"""Import of files and images, export of cages: `importers`, `exporters`, `pieces`, `pictures`, `layered`, `silhouette`."""
