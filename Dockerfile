# The program in a container, with the first example plant:  docker build -t canopus . && docker run --rm --network host canopus
# Another plant:  docker run --rm --network host -v "$PWD:/plants:ro" canopus run /plants/plant.toml
# --network host: its servers are on the machine's loopback, and it sees the machine's CAN interfaces.
FROM debian:12 AS build
COPY . /src
WORKDIR /src
RUN tools/install-packages build && tools/install-packages page && cmake --preset release -DCANOPUS_TESTS=OFF \
    && cmake --build build --target canopus page \
    && cmake --install build --prefix /usr --component program

FROM debian:12-slim
RUN apt-get update && apt-get install -y --no-install-recommends libfmt9 libtomlplusplus3 libpugixml1v5 libsystemd0 zlib1g \
    && rm -rf /var/lib/apt/lists/* && useradd --create-home canopus
COPY --from=build /usr/bin/canopus /usr/bin/canopus
COPY --from=build /usr/share/doc/canopus/examples /usr/share/doc/canopus/examples
COPY --from=build /usr/share/canopus /usr/share/canopus
USER canopus
ENTRYPOINT ["canopus"]
CMD ["run", "/usr/share/doc/canopus/examples/first-plant/plant.toml"]
