"""The records of sets of cages: the objects of a set, what is certified of them, and how they were before."""

from .cage_set import *  # noqa: F403 - all of these are the package's face
from .certificates import *  # noqa: F403 - all of these are the package's face
from .helpers import *  # noqa: F403 - all of these are the package's face
