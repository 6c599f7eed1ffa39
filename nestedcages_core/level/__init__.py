"""One level: the plan, the attempts, the builder and its report."""
