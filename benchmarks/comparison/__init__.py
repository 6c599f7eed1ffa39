"""The comparison of methods: what is compared, on which shapes, how it is measured, and how it is written down."""
