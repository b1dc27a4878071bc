# PL-LIT in a container: docker build -t pllit . && docker run --rm -it -v "$PWD:/data" pllit ./pllit run /data/drive.bag
FROM debian:trixie
COPY packages.txt /tmp/packages.txt
RUN apt-get update && sed -e 's/#.*//' -e '/^[[:space:]]*$/d' /tmp/packages.txt | xargs apt-get install -y --no-install-recommends \
    && rm -rf /var/lib/apt/lists/*
COPY . /pllit
WORKDIR /pllit
RUN ./pllit --version
CMD ["./demo"]
