#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds the documentation as pages, with mkdocs (a package of Debian's), in build/site/html.
#
#   scripts/site.sh
set -euo pipefail
cd "$(dirname "$0")/.."
command -v mkdocs >/dev/null || { echo "site: install mkdocs, by: apt-get install mkdocs" >&2; exit 1; }

site=build/site
rm -rf "$site"
mkdir -p "$site"
cp -r docs "$site/source"
mv "$site/source/mkdocs.yml" "$site"
# What is not among the pages is named without a link.
sed -E -e 's|\]\(docs/|](|g' -e 's/\[([^]]*)\]\((scripts|tests|LICENSE)[^)]*\)/\1/g' README.md >"$site/source/index.md"
find "$site/source" -name '*.md' -exec sed -i -E \
  -e 's|\]\(\.\./README\.md|](index.md|g' -e 's|\[([^]]*)\]\(\.\./[^)]*\)|\1|g' {} +
mkdocs build --quiet --strict --config-file "$site/mkdocs.yml"
echo "site: $site/html/index.html"
