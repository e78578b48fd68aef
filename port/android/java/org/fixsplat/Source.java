package org.fixsplat;

import java.io.ByteArrayOutputStream;
import java.io.Closeable;
import java.io.FileDescriptor;
import java.io.FileInputStream;
import java.io.IOException;
import java.io.InputStream;
import java.net.HttpURLConnection;
import java.net.URL;
import java.nio.ByteBuffer;
import java.nio.channels.FileChannel;
import java.util.function.DoubleConsumer;

/** The bytes of a scene. C calls `size`, `tryRead`, `cancel`, `arrived` and `progress`, on threads of the library. */
abstract class Source {
    private static final int MOST = 1 << 30, STEP = 1 << 20;
    final String name;
    private final DoubleConsumer told;
    private final Runnable awake;
    private volatile boolean isCancelled, hasFailed;

    /** `told` gets the share of the scene that was opened, `awake` runs when parts of the scene have arrived. */
    Source(String name, DoubleConsumer told, Runnable awake) {
        this.name = name;
        this.told = told;
        this.awake = awake;
    }

    abstract long size() throws IOException;

    /** Fills the buffer with the bytes at an offset. */
    abstract void read(long offset, ByteBuffer to) throws IOException;

    /** Ends reads in progress, from another thread. */
    abstract void stop();

    /** Returns the whole scene in a direct buffer. */
    ByteBuffer whole() throws IOException {
        if (size() > MOST)
            throw new IOException(name + ": " + size() + " bytes; without levels of detail, at most " + MOST);
        final ByteBuffer bytes = ByteBuffer.allocateDirect((int) size());
        while (bytes.hasRemaining()) {
            bytes.limit(Math.min(bytes.capacity(), bytes.position() + STEP));
            read(bytes.position(), bytes);
            progress((double) bytes.position() / bytes.capacity());
            bytes.limit(bytes.capacity());
        }
        return bytes;
    }

    /** Returns null, or why the buffer was not filled. */
    final String tryRead(long offset, ByteBuffer to) {
        try {
            read(offset, to);
            return null;
        } catch (IOException | RuntimeException fault) {
            hasFailed = true;
            return reason(fault);
        }
    }

    final String reason(Throwable fault) {
        return isCancelled ? name + ": cancelled" : reason(name, fault);
    }

    static String reason(String name, Throwable fault) {
        final String text = fault.getMessage() == null ? fault.toString() : fault.getMessage();
        return text.startsWith(name) ? text : name + ": " + text;
    }

    final void cancel() {
        isCancelled = true;
        stop();
    }

    final boolean isCancelled() {
        return isCancelled;
    }

    /** Whether bytes could not be read. */
    final boolean hasFailed() {
        return hasFailed;
    }

    final void arrived() {
        awake.run();
    }

    final boolean progress(double done) {
        told.accept(done);
        return isCancelled;
    }

    final IOException cut(ByteBuffer to) {
        return new IOException(name + ": ends " + to.remaining() + " bytes too early");
    }

    /** An asset that is compressed: all of a stream. */
    static final class OfStream extends Source {
        private final InputStream stream;

        OfStream(String name, InputStream stream, DoubleConsumer told, Runnable awake) {
            super(name, told, awake);
            this.stream = stream;
        }

        @Override long size() throws IOException {
            return stream.available();
        }

        @Override void read(long offset, ByteBuffer to) throws IOException {
            throw new IOException(name + ": is compressed");
        }

        @Override ByteBuffer whole() throws IOException {
            final ByteArrayOutputStream all = new ByteArrayOutputStream();
            final byte[] some = new byte[STEP];
            for (int got = 0; got >= 0; got = stream.read(some)) {
                all.write(some, 0, got);
                if (progress(0) || all.size() > MOST)
                    throw new IOException(name + ": " + (isCancelled() ? "cancelled" : "too large"));
            }
            final ByteBuffer bytes = ByteBuffer.allocateDirect(all.size());
            bytes.put(all.toByteArray());
            return bytes;
        }

        @Override void stop() {
        }
    }

    /** A part of an open file, which `owner` closes: a file, or an asset that is stored without compression. */
    static final class OfFile extends Source {
        private final Closeable owner;
        private final FileChannel channel;
        private final long start, size;

        OfFile(String name, Closeable owner, FileDescriptor file, long start, long size, DoubleConsumer told,
               Runnable awake) {
            super(name, told, awake);
            this.owner = owner;
            channel = new FileInputStream(file).getChannel();
            this.start = start;
            this.size = size;
        }

        @Override long size() {
            return size;
        }

        @Override void read(long offset, ByteBuffer to) throws IOException {
            while (to.hasRemaining()) {
                final int got = channel.read(to, start + offset);
                if (got < 0)
                    throw cut(to);
                offset += got;
            }
        }

        @Override ByteBuffer whole() throws IOException {
            return size < 1 || size > MOST ? super.whole() : channel.map(FileChannel.MapMode.READ_ONLY, start, size);
        }

        @Override void stop() {
            try {
                channel.close();
                owner.close();
            } catch (IOException fault) {
                return;
            }
        }
    }

    /** A file of a web server, read by range requests (RFC 9110, section 14). A request ends after `limit`
     *  milliseconds without an end, also if the server sends a byte now and then. */
    static final class OfAddress extends Source {
        private final URL url;
        private final int limit;
        private long size = -1;
        private String tag;
        private HttpURLConnection open;

        OfAddress(String address, int limit, DoubleConsumer told, Runnable awake) throws IOException {
            super(address, told, awake);
            url = new URL(address);
            this.limit = limit;
        }

        @Override long size() throws IOException {
            if (size < 0)
                read(0, ByteBuffer.allocate(1));
            return size;
        }

        @Override void read(long offset, ByteBuffer to) throws IOException {
            final HttpURLConnection connection = begin();
            final long late = System.nanoTime() + limit * 1000000L;
            try {
                connection.setRequestProperty("Range", "bytes=" + offset + "-" + (offset + to.remaining() - 1));
                connection.setRequestProperty("Accept-Encoding", "identity");
                connection.setConnectTimeout(limit);
                connection.setReadTimeout(limit);
                check(connection, offset);
                try (InputStream stream = connection.getInputStream()) {
                    final byte[] some = new byte[1 << 14];
                    while (to.hasRemaining()) {
                        final int got = stream.read(some, 0, Math.min(some.length, to.remaining()));
                        if (got < 0)
                            throw cut(to);
                        if (System.nanoTime() > late)
                            throw new IOException(name + ": no answer in " + limit + " ms");
                        to.put(some, 0, got);
                    }
                }
            } catch (java.net.SocketTimeoutException fault) {
                throw new IOException(name + ": no answer in " + limit + " ms");
            } finally {
                end(connection);
            }
        }

        private synchronized HttpURLConnection begin() throws IOException {
            if (isCancelled())
                throw new IOException(name + ": cancelled");
            open = (HttpURLConnection) url.openConnection();
            return open;
        }

        private synchronized void end(HttpURLConnection connection) {
            open = null;
            connection.disconnect();
        }

        /** Takes the size of the first answer; later answers must be of the same file. */
        private void check(HttpURLConnection connection, long offset) throws IOException {
            final int status = connection.getResponseCode();
            final String range = connection.getHeaderField("Content-Range");
            if (status != 206 || range == null || !range.matches("bytes " + offset + "-\\d+/\\d{1,18}"))
                throw new IOException(name + ": " + (status == 200 ? "the server does not send parts of files"
                                                                   : "the server answered with " + status));
            final long whole = Long.parseLong(range.substring(range.indexOf('/') + 1));
            final String now = String.valueOf(connection.getHeaderField("ETag"));
            if (size >= 0 && (whole != size || !now.equals(tag)))
                throw new IOException(name + ": the file has changed");
            size = whole;
            tag = now;
        }

        @Override synchronized void stop() {
            if (open != null)
                open.disconnect();
        }
    }
}
