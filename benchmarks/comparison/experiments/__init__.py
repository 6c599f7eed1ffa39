"""One experiment for each question: what is run, the tables and plots of it, and what the measurements say.

Every module has ``run(inputs, bench)``, which gives the measurements, ``section(found, inputs, pictures)``, which
writes its plots into the folder and gives its page, and ``finding(found, inputs)``, sentences with numbers computed.
"""

from __future__ import annotations

from . import (
    contacts,
    decimations,
    energies,
    figures,
    filters,
    flows,
    panes,
    product,
    random_shapes,
    reuse,
    scaling,
    staircase,
    sweeps,
    table_one,
)

EXPERIMENTS = {
    "contacts": contacts,
    "sweeps": sweeps,
    "scaling": scaling,
    "table 1": table_one,
    "figures 1 to 5": panes,
    "figures": figures,
    "random shapes": random_shapes,
    "staircase": staircase,
    "contacts, starts, energies": product,
    "energies": energies,
    "step filters": filters,
    "flows": flows,
    "reuse": reuse,
    "decimations": decimations,
}
"""Name -> module, in the order of the pages."""
