# Two commands matter: `make run` (the window, or the main job when there is no display) and `make test`.
VENV := .venv
PYTHON := $(VENV)/bin/python
APT := libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri libgles2 libxkbcommon0 libdbus-1-3 libfontconfig1 fonts-dejavu-core \
  libxkbcommon-x11-0 libxcb-cursor0 libxcb-icccm4 libxcb-image0 libxcb-keysyms1 libxcb-render-util0 libxcb-shape0 libxcb-xkb1 \
  libxrender1 libglib2.0-0 libwayland-cursor0 libwayland-egl1 libportaudio2
PACKAGE_APT := xvfb xauth xdotool binutils
STAMP := $(VENV)/.installed

.PHONY: run test lint setup package clean

setup: $(STAMP)

# Debian's packages give the offscreen renderer its software GL, Qt its libraries and playback its PortAudio. Skipped where apt-get is absent.
$(STAMP): pyproject.toml Makefile
	@if command -v apt-get >/dev/null && ! dpkg -s $(APT) >/dev/null 2>&1; then \
	  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $(APT); fi
	@if ! python3 -c 'import ensurepip' 2>/dev/null && command -v apt-get >/dev/null; then \
	  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends python3-venv; fi
	test -x $(PYTHON) || python3 -m venv $(VENV)
	$(PYTHON) -m pip install -q --upgrade pip
	$(PYTHON) -m pip install -q -e '.[dev]'
	touch $(STAMP)

run: setup
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then $(PYTHON) -m app $(TAKE); else $(PYTHON) -m app.main_job $(TAKE); fi

lint: setup
	$(PYTHON) -m ruff check .
	$(PYTHON) -m ruff format --check .
	$(PYTHON) -m mypy
	$(VENV)/bin/lint-imports

# Journeys run in a process of their own, and one that failed is tried again and named: they press real keys and wait for real time.
test: lint
	QT_QPA_PLATFORM=offscreen $(PYTHON) -m pytest --ignore=tests/journeys
	QT_QPA_PLATFORM=offscreen $(PYTHON) -m pytest tests/journeys --reruns 2

# The wheel, the desktop bundle and the Debian package, each tried as a user would. Built in an environment of their own, so that
# nothing of the developer's travels along.
PACK := build/package
package:
	@if command -v apt-get >/dev/null && ! dpkg -s $(APT) $(PACKAGE_APT) >/dev/null 2>&1; then \
	  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $(APT) $(PACKAGE_APT); fi
	rm -rf $(PACK) && python3 -m venv $(PACK)/venv
	$(PACK)/venv/bin/python -m pip install -q --upgrade pip
	$(PACK)/venv/bin/python -m pip wheel -q --no-deps -w $(PACK)/dist .
	$(PACK)/venv/bin/python -m pip install -q $(PACK)/dist/*.whl
	$(PACK)/venv/bin/python packaging/smoke.py $(PACK)/venv/bin/retake
	$(PACK)/venv/bin/python -m pip install -q 'pyinstaller>=6.22,<7'
	$(PACK)/venv/bin/python -m PyInstaller --noconfirm --log-level ERROR --distpath $(PACK)/bundle --workpath $(PACK)/work packaging/retake.spec
	$(PACK)/venv/bin/python packaging/smoke.py $(PACK)/bundle/retake/retake
	$(PACK)/venv/bin/python packaging/deb.py $(PACK)/bundle/retake $(PACK)/dist
	ls -l $(PACK)/dist && du -sh $(PACK)/bundle/retake

clean:
	rm -rf $(VENV) out runs build
