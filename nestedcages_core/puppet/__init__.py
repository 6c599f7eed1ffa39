from .graph import links_of
from .links import Choice, Hold, Link
from .parts import PuppetPart, with_unique_names
