"""Import of files and images, export of cages: `importers`, `exporters`, `image_outline`, `cutout`, `silhouette`."""
