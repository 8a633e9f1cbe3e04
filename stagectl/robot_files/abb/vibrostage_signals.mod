MODULE VibrostageSignals
    ! vibrostage: sends angles and torques of the motors, in a background task T_LOG without motion.
    ! Needs the options PC Interface (616-1) and Multitasking (623-1).
    ! Written from the maker's manuals, tried on a simulator only, not on a controller.
    !
    ! A line is the time (s, of this task's clock), six angles (deg) and six torques (N m, from the arm's side of the
    ! gears), with commas between them, and ends with a line feed.

    CONST num VS_SIGNALS := @signals@;

    ! Turns of each motor for one of its joint, with its sign: fill in, from Motion > Transmission of the controller.
    ! Torques of a wrist whose motors turn other joints, too, are not taken apart.
    CONST num VS_GEAR{6} := [1, 1, 1, 1, 1, 1];
    CONST num VS_PERIOD := 0.004;

    VAR socketdev vsServer;
    VAR socketdev vsClient;
    VAR clock vsClock;

    PROC main()
        TestSignalReset;
        FOR i FROM 1 TO 6 DO
            TestSignalDefine i, torque_ref, ROB_1, i, VS_PERIOD;
        ENDFOR
        ClkReset vsClock;
        ClkStart vsClock;
        SocketClose vsClient;
        SocketClose vsServer;
        SocketCreate vsServer;
        SocketBind vsServer, GetSysInfo(\LanIp), VS_SIGNALS;
        SocketListen vsServer;
        WHILE TRUE DO
            SocketAccept vsServer, vsClient \Time:=WAIT_MAX;
            VsLog;
            SocketClose vsClient;
        ENDWHILE
    ENDPROC

    ! A string holds 80 characters: a line is put together in raw bytes.
    PROC VsLog()
        VAR rawbytes line;
        VAR jointtarget here;
        WHILE TRUE DO
            ClearRawBytes line;
            here := CJointT(\TaskRef:=T_ROB1Id);
            VsPut line, NumToStr(ClkRead(vsClock \HighRes), 4);
            VsPut line, "," + NumToStr(here.robax.rax_1, 4);
            VsPut line, "," + NumToStr(here.robax.rax_2, 4);
            VsPut line, "," + NumToStr(here.robax.rax_3, 4);
            VsPut line, "," + NumToStr(here.robax.rax_4, 4);
            VsPut line, "," + NumToStr(here.robax.rax_5, 4);
            VsPut line, "," + NumToStr(here.robax.rax_6, 4);
            FOR i FROM 1 TO 6 DO
                VsPut line, "," + NumToStr(VS_GEAR{i} * TestSignalRead(i), 3);
            ENDFOR
            VsPut line, "\0A";
            SocketSend vsClient \RawData:=line;
            WaitTime VS_PERIOD;
        ENDWHILE
    ERROR
        ! closed
        RETURN;
    ENDPROC

    PROC VsPut(VAR rawbytes line, string text)
        PackRawBytes text, line, RawBytesLen(line) + 1 \ASCII;
    ENDPROC
ENDMODULE
