"""From drawings to certified cages in the coordinates that Blender stores, in slices that can be cancelled."""
