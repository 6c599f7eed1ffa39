"""The comparison of methods. In the order in which one would explain the files:

- `methods`: what is compared; `shapes`, `held_out`, `drawings`: on what.
- `measure`: one run of one method on one shape; `bench`: many runs on several cores, each kept.
- `experiments`: which method runs on which shapes; `runs`: every run as a line of a file.
- `statistics`: spreads, paired tests and bootstrap intervals; `conclusions`: three claims, and whether the runs hold.
- `pages`, `tables`, `pictures`: what is written, from the file of runs alone; `check`: whether it still holds.
"""
