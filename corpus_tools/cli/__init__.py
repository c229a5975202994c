"""The batch command ``corpus-tools``."""

import os

__all__: list[str] = []

# Equal runs give equal bytes only with one BLAS thread; this must stand before numpy is imported.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
