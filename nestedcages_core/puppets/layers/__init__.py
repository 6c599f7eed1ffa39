"""Layered paintings and drawings in: PSD, OpenRaster, Krita, SVG and folders of PNG pictures, as painted parts."""
