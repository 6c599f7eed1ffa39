"""One experiment for each question: what is run, the tables and plots of it, and what the measurements say.

Every module has ``run(inputs)``, which gives the measurements, ``section(found, inputs, pictures)``, which writes its
plots into the folder and gives its part of the document, and ``finding(found, inputs)``, sentences whose numbers and
verdicts are computed.
"""

from __future__ import annotations

from . import (
    alone,
    decimations,
    energies,
    figures,
    filters,
    product,
    quadratures,
    random_shapes,
    staircase,
    table_one,
)

EXPERIMENTS = {
    "table 1": table_one,
    "staircase": staircase,
    "figures": figures,
    "random shapes": random_shapes,
    "contacts, starts, energies": product,
    "energies": energies,
    "contacts alone": alone,
    "step filters": filters,
    "decimations": decimations,
    "quadratures": quadratures,
}
"""Name -> module, in the order of the document."""
