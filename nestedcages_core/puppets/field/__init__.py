"""Fields of parts that bend: triangles, weights of bones, how bones blend, and proved ranges of joints."""
