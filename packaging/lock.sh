#!/bin/sh
# Renew requirements.lock: exact versions with their hashes, for a bundle of Linux x86-64 and Python 3.11.
#
# Needs uv (pip install uv). PyTorch's build for processors must be within reach: name its index in UV_EXTRA_INDEX_URL or
# a folder with its wheel in UV_FIND_LINKS. Neither is written to the file. Afterwards run the tests, then look at what
# changed: a new package needs a row in THIRD_PARTY.md.
# Install from it without looking at what the packages themselves ask for, of which overrides.txt overrides two:
#   pip install --require-hashes --no-deps -r packaging/requirements.lock
set -eu
cd "$(dirname "$0")/.."
{
  echo "# Exact versions and hashes of what the bundle holds. Made by packaging/lock.sh, which says how it is renewed."
  uv pip compile pyproject.toml --override packaging/overrides.txt --generate-hashes --upgrade --quiet \
    --python-version 3.11 --python-platform x86_64-manylinux_2_34 \
    --no-emit-index-url --no-emit-find-links --no-annotate --no-header
} > packaging/requirements.lock.new
mv packaging/requirements.lock.new packaging/requirements.lock
