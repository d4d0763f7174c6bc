#!/usr/bin/env bash
# Hostile bytes for every reader, SECONDS each (600 by default); see fuzz/README.md for what must hold.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${SECONDS_EACH:-600}
limits=(-max_total_time="$seconds" -timeout=10 -rss_limit_mb=1024)

cargo fuzz --version >/dev/null 2>&1 || { echo "cargo-fuzz is missing: run 'cargo install cargo-fuzz' (and 'rustup toolchain install nightly')." >&2; exit 1; }
.venv/bin/python -c 'import atheris' 2>/dev/null || .venv/bin/python -m pip install --quiet atheris
mkdir -p fuzz/corpus/{bvh_reader,amc_reader,gltf,gmr_text,gmr_binary,parse_rows,format_rows,bvh_bytes,amc_frames,database_file}

.venv/bin/python fuzz/bvh_reader.py -dict=fuzz/bvh.dict "${limits[@]}" -max_len=4096 fuzz/corpus/bvh_reader fuzz/seeds/bvh
.venv/bin/python fuzz/amc_reader.py -dict=fuzz/amc.dict "${limits[@]}" -max_len=4096 fuzz/corpus/amc_reader fuzz/seeds/amc
.venv/bin/python fuzz/gltf_reader.py -dict=fuzz/gltf.dict "${limits[@]}" -max_len=12000 fuzz/corpus/gltf fuzz/seeds/gltf
for form in text binary; do
    .venv/bin/python "fuzz/gmr_${form}_reader.py" -dict=fuzz/gmr.dict "${limits[@]}" -max_len=4096 "fuzz/corpus/gmr_$form" tests/data/gmr/valid tests/data/gmr/invalid
done
.venv/bin/python fuzz/c3d_parameters.py --count 3000
cargo +nightly fuzz run parse_rows fuzz/corpus/parse_rows -- -dict=fuzz/bvh.dict "${limits[@]}" -max_len=4096
cargo +nightly fuzz run format_rows fuzz/corpus/format_rows -- "${limits[@]}"
cargo +nightly fuzz run bvh_bytes fuzz/corpus/bvh_bytes fuzz/seeds/bvh -- -dict=fuzz/bvh.dict "${limits[@]}" -max_len=4096
cargo +nightly fuzz run amc_frames fuzz/corpus/amc_frames -- -dict=fuzz/amc.dict "${limits[@]}" -max_len=4096
cargo +nightly fuzz run database_file fuzz/corpus/database_file fuzz/seeds/database -- "${limits[@]}" -max_len=16384
