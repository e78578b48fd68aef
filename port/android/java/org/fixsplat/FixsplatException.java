package org.fixsplat;

import java.io.IOException;
import java.nio.charset.StandardCharsets;

/** A fault of the library, with its one line of text as the message. */
public final class FixsplatException extends IOException {
    private static final long serialVersionUID = 1;
    /** The code FXS_ERR_* of fixsplat.h. */
    public final int code;

    FixsplatException(int code, byte[] text) {
        super(new String(text, StandardCharsets.UTF_8));
        this.code = code;
    }

    /** A fault of Java's while a scene was read: FXS_ERR_FILE. */
    FixsplatException(String text) {
        super(text);
        code = -11;
    }
}
