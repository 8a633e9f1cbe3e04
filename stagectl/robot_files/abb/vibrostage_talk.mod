MODULE VibrostageTalk
    ! vibrostage: answers the lines of stagectl, in a background task T_TALK without motion.
    ! Needs the options PC Interface (616-1) and Multitasking (623-1).
    ! Written from the maker's manuals, tried on a simulator only, not on a controller.
    !
    ! A line is a word and numbers, and ends with a line feed; so does the answer: OK, or ERROR and why.

    CONST num VS_COMMANDS := @commands@;

    ! -- shared with VibrostageMotion, the same in both
    PERS num vsAsked := 0;
    PERS num vsDone := 0;
    PERS num vsKind := 0;
    PERS num vsSoft{6} := [0, 0, 0, 0, 0, 0];
    CONST num VS_SOFT := 1;
    CONST num VS_RESET := 2;

    ! s for the motion task to do something; s for clamp, changer and spindle
    CONST num VS_PATIENCE := 1;
    CONST num VS_SLOW := 30;

    VAR socketdev vsServer;
    VAR socketdev vsClient;
    VAR string vsRest := "";

    PROC main()
        SocketClose vsClient;
        SocketClose vsServer;
        SocketCreate vsServer;
        SocketBind vsServer, GetSysInfo(\LanIp), VS_COMMANDS;
        SocketListen vsServer;
        WHILE TRUE DO
            SocketAccept vsServer, vsClient \Time:=WAIT_MAX;
            vsRest := "";
            VsServe;
            SocketClose vsClient;
        ENDWHILE
    ENDPROC

    ! Answer line by line until the PC hangs up.
    PROC VsServe()
        VAR string part;
        VAR num at;
        WHILE TRUE DO
            SocketReceive vsClient \Str:=part \Time:=WAIT_MAX;
            vsRest := vsRest + part;
            at := StrFind(vsRest, 1, "\0A");
            WHILE at <= StrLen(vsRest) DO
                part := StrPart(vsRest, 1, at - 1);
                IF at < StrLen(vsRest) THEN
                    vsRest := StrPart(vsRest, at + 1, StrLen(vsRest) - at);
                ELSE
                    vsRest := "";
                ENDIF
                VsDo part;
                at := StrFind(vsRest, 1, "\0A");
            ENDWHILE
        ENDWHILE
    ERROR
        ! closed, or a line too long
        RETURN;
    ENDPROC

    PROC VsSay(string answer)
        SocketSend vsClient \Str:=answer + "\0A";
    ENDPROC

    PROC VsDo(string line)
        VAR string word;
        VAR string rest := "";
        VAR num at;
        VAR num soft{6};
        IF StrLen(line) = 0 THEN
            VsSay "ERROR a line is empty";
            RETURN;
        ENDIF
        at := StrFind(line, 1, " ");
        word := StrPart(line, 1, at - 1);
        IF at < StrLen(line) THEN
            rest := StrPart(line, at + 1, StrLen(line) - at);
        ENDIF
        TEST word
        CASE "SOFT":
            IF VsSix(rest, soft) THEN
                vsSoft := soft;
                VsMotion VS_SOFT;
            ELSE
                VsSay "ERROR softness must be 6 numbers from 0 to 0.99";
            ENDIF
        CASE "CLAMP":
            TEST rest
            CASE "1":
                SetDO doVsClamp, 1;
                VsAwait diVsClamped, 1, "the clamp";
            CASE "0":
                SetDO doVsClamp, 0;
                VsAwait diVsClamped, 0, "the clamp";
            DEFAULT:
                VsSay "ERROR CLAMP must be 1 or 0";
            ENDTEST
        CASE "BLOCK":
            TEST rest
            CASE "1":
                SetDO doVsBlock, 1;
                VsAwait diVsBlock, 1, "the changer";
            CASE "0":
                SetDO doVsBlock, 0;
                VsAwait diVsBlock, 0, "the changer";
            DEFAULT:
                VsSay "ERROR BLOCK must be 1 or 0";
            ENDTEST
        CASE "SPINDLE":
            TEST rest
            CASE "1":
                SetDO doVsSpindle, 1;
                VsAwait diVsSpindle, 1, "the spindle";
            CASE "0":
                SetDO doVsSpindle, 0;
                VsAwait diVsSpindle, 0, "the spindle";
            DEFAULT:
                VsSay "ERROR SPINDLE must be 1 or 0";
            ENDTEST
        CASE "RESET":
            ! wired by the lab to the system input Motors On: see docs/robot-files.md
            PulseDO \PLength:=0.2, doVsMotorsOn;
            VsMotion VS_RESET;
        DEFAULT:
            VsSay "ERROR it is none of SOFT, CLAMP, BLOCK, SPINDLE, RESET";
        ENDTEST
    ENDPROC

    ! Have the motion task do something, and answer once it has.
    PROC VsMotion(num kind)
        VAR bool late := FALSE;
        vsKind := kind;
        vsAsked := vsAsked + 1;
        WaitUntil vsDone = vsAsked \MaxTime:=VS_PATIENCE \TimeFlag:=late;
        IF late THEN
            VsSay "ERROR the motion task does not answer: start its program";
        ELSE
            VsSay "OK";
        ENDIF
    ENDPROC

    ! Answer once an input says that it is done.
    PROC VsAwait(VAR signaldi input, num value, string what)
        VAR bool late := FALSE;
        WaitDI input, value \MaxTime:=VS_SLOW \TimeFlag:=late;
        IF late THEN
            VsSay "ERROR " + what + " does not say that it is there";
        ELSE
            VsSay "OK";
        ENDIF
    ENDPROC

    ! Read six numbers from 0 to 0.99, with a space between them.
    FUNC bool VsSix(string text, VAR num value{*})
        VAR num start := 1;
        VAR num at;
        FOR i FROM 1 TO 6 DO
            IF start > StrLen(text) RETURN FALSE;
            at := StrFind(text, start, " ");
            IF at = start RETURN FALSE;
            IF NOT StrToVal(StrPart(text, start, at - start), value{i}) RETURN FALSE;
            IF value{i} < 0 OR value{i} > 0.99 RETURN FALSE;
            start := at + 1;
        ENDFOR
        RETURN start > StrLen(text);
    ENDFUNC
ENDMODULE
