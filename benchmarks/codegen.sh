#!/usr/bin/env bash
# Run a command under another code generation: benchmarks/codegen.sh host|generic|nofma command ...
# Each has a compile cache of its own below CODEGEN_CACHE (default: a folder in the user's cache).
# generic: no instruction beyond the baseline. nofma: those of this machine without fused multiply-add, and what needs it
# (avx512). numba fuses and reorders nothing by itself (measured: the same bits in all three), so what makes machines
# differ is the sine of the C library and LAPACK: nofma takes their variants without fused multiply-add too.
set -euo pipefail

mode=$1
shift
python=$1
case $mode in
host) ;;
generic) export NUMBA_CPU_NAME=generic ;;
nofma)
    features=$("$python" -c '
from llvmlite import binding
have = binding.get_host_cpu_features()
left_out = [name for name in have if name in ("fma", "fma4") or name.startswith(("avx512", "avx10"))]
names = [name for name, on in have.items() if on and name not in left_out]
print(",".join(["+" + name for name in names] + ["-" + name for name in left_out]))')
    NUMBA_CPU_NAME=$("$python" -c 'from llvmlite import binding; print(binding.get_host_cpu_name())')
    export NUMBA_CPU_NAME NUMBA_CPU_FEATURES=$features
    export GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-FMA_Usable,-AVX2_Usable OPENBLAS_CORETYPE=Nehalem
    ;;
*)
    echo "host, generic or nofma, not $mode" >&2
    exit 2
    ;;
esac
export NUMBA_CACHE_DIR=${CODEGEN_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/tlismni-codegen}/$mode
exec "$@"
