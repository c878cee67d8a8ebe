# softarm_estimator on Debian 12; doc/install.md says how to use it. The steps are those of scripts/demo and scripts/softarm.
FROM debian:12
SHELL ["/bin/bash", "-c"]
ENV LANG=C.UTF-8
WORKDIR /opt/softarm_estimator

# The packages first: they stay in the cache while the code changes.
COPY scripts/lib.sh scripts/packages.txt scripts/
RUN source scripts/lib.sh && install_packages build

COPY . .
RUN source scripts/lib.sh && build live && build programs

CMD ["bash", "--rcfile", "build/install/setup.bash", "-i"]
