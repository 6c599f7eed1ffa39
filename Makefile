# Everything here works from a fresh clone: the first run of a command makes its own virtual environment.
# Needs make and Python 3.11 or 3.13, the two that Blender is built for as a Python module.

DEMO_ENV := .venv-demo
TEST_ENV := .venv-test
DOCS_ENV := .venv-docs

# Any name of a Python that runs, has a matching version and can make virtual environments.
USABLE := import sys, venv, ensurepip; sys.exit(sys.version_info[:2] not in ((3, 11), (3, 13)))
FOUND := $(shell for name in python3.11 python3.13 python3 python; do \
	if $$name -c '$(USABLE)' >/dev/null 2>&1; then echo $$name; break; fi; done)
PYTHON ?= $(FOUND)

# Tests share the cores; more than four processes with Blender in each need more memory than they save time.
WORKERS ?= -n auto --maxprocesses 4

# The matrices here are small: threads of the linear algebra would only wait for each other where cores are few.
export OPENBLAS_NUM_THREADS ?= 1
export OMP_NUM_THREADS ?= 1

# A run that hangs is ended from outside too, where the system has the command for it.
LIMIT := $(shell command -v timeout >/dev/null 2>&1 && echo timeout -k 10)

.DELETE_ON_ERROR:
.PHONY: help demo test test-fast check coverage lint docs pictures bench extension nodes release test-blender clean

help:
	@echo "make demo    draws cages around examples/letter_a.svg in Blender: build/demo/letter_a.blend and .png"
	@echo "make test    runs every test of the core and of the add-on, but those of make check"
	@echo "make test-fast     leaves out the slow ones, for use while working"
	@echo "make check   runs the examples, the programs of the documentation and the demo, and looks at their pictures"
	@echo "make coverage      reports how much of each file of the core the tests run"
	@echo "make lint    runs ruff and mypy"
	@echo "make docs    builds the site with the API reference: build/site/index.html"
	@echo "make pictures      makes the pictures of README, gallery and guide again (NAMES=..., BLENDER=command of one with a window)"
	@echo "make bench   lists the benchmarks; make bench NAMES=\"golden speed\" runs some"
	@echo "make release   puts the extension, its listing, wheel, sdist, site and checksums into dist/"
	@echo "make extension     builds the extension's zips in dist/, installs the Linux one in a clean Blender and tries it"
	@echo "make nodes   builds the node groups and materials that the extension appends: addon/blender/nodes.blend"
	@echo "make test-blender  runs the add-on's tests on every Blender supported"
	@echo "make clean   removes the environments and everything built"

demo: $(DEMO_ENV)/ready
	@$(DEMO_ENV)/bin/python examples/check_bpy.py
	$(DEMO_ENV)/bin/python examples/demo.py

test: $(TEST_ENV)/ready
	@$(TEST_ENV)/bin/python examples/check_bpy.py
	$(if $(LIMIT),$(LIMIT) 1400) $(TEST_ENV)/bin/python -m pytest $(WORKERS)

test-fast: $(TEST_ENV)/ready
	@$(TEST_ENV)/bin/python examples/check_bpy.py
	$(if $(LIMIT),$(LIMIT) 300) $(TEST_ENV)/bin/python -m pytest -q $(WORKERS) --dist loadfile -m "not slow and not thorough and not check"

check: $(TEST_ENV)/ready
	@$(TEST_ENV)/bin/python examples/check_bpy.py
	$(if $(LIMIT),$(LIMIT) 900) $(TEST_ENV)/bin/python -m pytest -q $(WORKERS) -m check

coverage: $(TEST_ENV)/ready
	$(TEST_ENV)/bin/python -m pip install --quiet --disable-pip-version-check coverage
	$(TEST_ENV)/bin/python -m coverage run --source=nestedcages_core -m pytest -q tests/core tests/files tests/kernels
	$(TEST_ENV)/bin/python -m coverage report

lint: $(TEST_ENV)/ready
	$(TEST_ENV)/bin/python -m ruff check .
	$(TEST_ENV)/bin/python -m ruff format --check .
	$(TEST_ENV)/bin/python -m mypy

docs: $(DOCS_ENV)/ready
	$(DOCS_ENV)/bin/python packaging/docs_pages.py
	NO_MKDOCS_2_WARNING=1 $(DOCS_ENV)/bin/python -m mkdocs build --strict --quiet
	@echo "Open build/site/index.html"

# NAMES: only some, such as NAMES="demo bend". BLENDER: the command of a Blender 4.3 or 5.2 with a window of 1280 x 800,
# for the pictures of the guide; without it, those of README and gallery.
pictures: $(TEST_ENV)/ready
	$(if $(BLENDER),$(BLENDER) --factory-startup -p 0 0 1280 800 --python packaging/pictures.py -- $(NAMES),\
		$(TEST_ENV)/bin/python packaging/pictures.py $(NAMES))

bench: $(TEST_ENV)/ready
	$(TEST_ENV)/bin/python -m pip install --quiet --disable-pip-version-check --editable ".[benchmark,cluster]"
	$(TEST_ENV)/bin/python benchmarks/run.py $(NAMES)

extension: $(TEST_ENV)/ready
	@$(TEST_ENV)/bin/python examples/check_bpy.py
	$(TEST_ENV)/bin/python packaging/build_extension.py
	$(TEST_ENV)/bin/python packaging/try_extension.py

# In the oldest Blender supported, so that all read the file.
nodes:
	@test -e .venv-bpy-4.2.23/ready || $(MAKE) test-blender-3.11-4.2.23
	.venv-bpy-4.2.23/bin/python packaging/node_groups.py

release: $(TEST_ENV)/ready docs
	$(TEST_ENV)/bin/python -m pip install --quiet --disable-pip-version-check --editable ".[packaging,examples]"
	$(TEST_ENV)/bin/python packaging/release.py
	$(TEST_ENV)/bin/python packaging/try_extension.py

# Blender as a Python module comes for one Python each; those of a Python that is not here are left out. A Python that
# pyenv has installed counts, even if it is not the one in use. IF_POSSIBLE=1: so are those that cannot be downloaded.
BLENDERS_3.11 ?= 4.2.0 4.2.23 4.3.0 4.4.0 4.5.15 5.0.1
BLENDERS_3.13 ?= 5.2.3
SCIPY_3.11 := 1.15.3
SCIPY_3.13 := 1.17.1
test-blender: $(foreach version,3.11 3.13,$(addprefix test-blender-$(version)-,$(BLENDERS_$(version))))

# $(1): Python, $(2): Blender.
define blender_tests
.PHONY: test-blender-$(1)-$(2)
test-blender-$(1)-$(2):
	@python=; for found in python$(1) "$$$$(pyenv prefix $(1) 2>/dev/null)/bin/python$(1)"; do \
		if "$$$$found" -c 'import venv' >/dev/null 2>&1; then python=$$$$found; break; fi; done; \
	if [ -z "$$$$python" ]; then echo "== Blender $(2) is left out: no Python $(1) here"; exit 0; fi; \
	env=.venv-bpy-$(2); \
	if [ ! -e $$$$env/ready ]; then "$$$$python" -m venv --clear $$$$env && $$$$env/bin/python -m pip install --quiet \
		--disable-pip-version-check bpy==$(2) scipy==$$(SCIPY_$(1)) pytest pytest-timeout shapely tinycss2 cssselect2 pillow psd-tools hypothesis markdown-it-py && \
		touch $$$$env/ready || { echo "== Blender $(2) cannot be installed"; exit $$(if $$(IF_POSSIBLE),0,1); }; fi; \
	echo "== Blender $(2)"; \
	$(if $(LIMIT),$(LIMIT) 600) $$$$env/bin/python -m pytest -q tests/addon
endef
$(foreach version,3.11 3.13,$(foreach blender,$(BLENDERS_$(version)),$(eval $(call blender_tests,$(version),$(blender)))))

clean:
	rm -rf .venv-bpy-* $(DEMO_ENV) $(TEST_ENV) $(DOCS_ENV) build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info

# $(1): environment, $(2): extras of pyproject.toml. The file `ready` says that the installation went through.
define environment
$(1)/ready: pyproject.toml
	@if [ -z "$$(PYTHON)" ] || ! "$$(PYTHON)" -c '$(USABLE)' >/dev/null 2>&1; then \
		echo "Nested Cages needs Python 3.11 or 3.13 with its venv module: install python3.11 and python3.11-venv" \
			"(Debian, Ubuntu), python3.11 (Fedora, Homebrew) or a release from python.org," \
			"or name one with 'make PYTHON=/path/to/python3.11'." >&2; exit 1; fi
	@echo "Making $(1) with $$$$("$$(PYTHON)" --version) (first run: this downloads what it needs)"
	"$$(PYTHON)" -m venv --clear $(1)
	$(1)/bin/python -m pip install --quiet --disable-pip-version-check --editable ".[$(2)]"
	@touch $$@
endef
$(eval $(call environment,$(DEMO_ENV),blender))
$(eval $(call environment,$(TEST_ENV),dev))
$(eval $(call environment,$(DOCS_ENV),docs))
