"""Files and images to drawings, and cages to files and other objects: `importers`, `exporters`, `image_outline`."""
