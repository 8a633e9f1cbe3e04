# The programs and the simulated laboratory, without devices:
#   docker build --build-arg VERSION=0.1.0 -t vibrostage .
#   docker run --rm -v "$PWD":/work --user "$(id -u)" vibrostage vibrator run --help
FROM python:3.13-slim AS build
ARG VERSION=0.1.0
WORKDIR /source
COPY pyproject.toml MANIFEST.in README.md LICENSE CHANGELOG.md ./
COPY packaging packaging
COPY ctlblocks ctlblocks
COPY rigkit rigkit
COPY vibractl vibractl
COPY stagectl stagectl
COPY calibration calibration
COPY firmware_sim firmware_sim
COPY vibrostage vibrostage
RUN SETUPTOOLS_SCM_PRETEND_VERSION="$VERSION" pip wheel --no-cache-dir --no-deps --wheel-dir /wheels .

FROM python:3.13-slim
# PortAudio, for `vibractl` with a sound card; the simulated one needs none.
# hadolint ignore=DL3008
RUN apt-get update \
 && apt-get install -y --no-install-recommends libportaudio2 \
 && rm -rf /var/lib/apt/lists/*
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels pip install --no-cache-dir /wheels/*.whl
RUN useradd --create-home --uid 10001 vibrostage \
 && install -d -m 1777 /work /cache
# Any user may run it: compiled loops, FFT plans and Matplotlib's fonts go where everybody may write.
ENV HOME=/cache XDG_CACHE_HOME=/cache NUMBA_CACHE_DIR=/cache/numba MPLCONFIGDIR=/cache/matplotlib OPENBLAS_NUM_THREADS=1
USER 10001
WORKDIR /work
ENTRYPOINT ["vibrostage"]
CMD ["--help"]
