"""The paper's method as published, behind the same protocols as ours. Others' are in `benchmarks/published`."""
