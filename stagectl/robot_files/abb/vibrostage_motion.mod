MODULE VibrostageMotion
    ! vibrostage: guided motion from where the robot stands, in the motion task T_ROB1.
    ! Needs the options Externally Guided Motion (689-1) and Multitasking (623-1).
    ! Written from the maker's manuals, tried on a simulator only, not on a controller.
    !
    ! Configuration > Communication > Transmission Protocol: "vibrostage", type UDPUC,
    ! remote address @listen@, remote port number @port@: the PC.

    ! -- shared with VibrostageTalk, the same in both
    PERS num vsAsked := 0;
    PERS num vsDone := 0;
    PERS num vsKind := 0;
    PERS num vsSoft{6} := [0, 0, 0, 0, 0, 0];
    ! -- what is asked for
    CONST num VS_SOFT := 1;
    CONST num VS_RESET := 2;

    ! TRUE for poses of the tool (stagectl midrange and step), FALSE for joints (all others)
    PERS bool vsPose := FALSE;
    PERS tooldata vsTool := [TRUE, [[0, 0, @tool@], [1, 0, 0, 0]], [1, [0, 0, 50], [1, 0, 0, 0], 0, 0, 0]];

    ! -- limits of the controller; those of cell.toml hold before them
    ! s without an answer of the PC
    CONST num VS_COMM_TIMEOUT := @comm_timeout@;
    ! Hz, low-pass for what is asked for
    CONST num VS_FILTER := @filter@;
    ! deg from where guided motion began, deg/s that a joint is asked to turn by
    CONST num VS_DEVIATION := @deviation@;
    CONST num VS_SPEED := @speed@;
    ! s
    CONST num VS_RAMP_IN := 0.05;
    CONST num VS_RAMP_OUT := @stop@;
    ! s within a window after which guided motion would end by itself: never
    CONST num VS_FOR := 1000000;
    CONST egm_minmax VS_WINDOW := [-0.001, 0.001];
    CONST pose VS_HERE := [[0, 0, 0], [1, 0, 0, 0]];

    VAR egmident vsEgm;
    VAR bool vsBegin := TRUE;

    PROC main()
        vsDone := vsAsked;
        vsBegin := TRUE;
        WHILE TRUE DO
            VsPrepare;
            VsGuide;
        ENDWHILE
    ENDPROC

    ! Report from where the robot stands.
    PROC VsPrepare()
        VAR jointtarget here;
        ! guided motion begins after a move to a fine point: by almost nothing
        here := CJointT();
        here.robax.rax_6 := here.robax.rax_6 + 0.0001;
        MoveAbsJ here, v10, fine, vsTool;
        EGMReset vsEgm;
        EGMGetId vsEgm;
        IF vsPose THEN
            EGMSetupUC ROB_1, vsEgm, "default", "vibrostage" \Pose \CommTimeout:=VS_COMM_TIMEOUT;
            EGMActPose vsEgm \StreamStart \Tool:=vsTool \WObj:=wobj0, VS_HERE, EGM_FRAME_BASE, VS_HERE, EGM_FRAME_BASE
                \X:=VS_WINDOW \Y:=VS_WINDOW \Z:=VS_WINDOW \Rx:=VS_WINDOW \Ry:=VS_WINDOW \Rz:=VS_WINDOW
                \LpFilter:=VS_FILTER \SampleRate:=4 \MaxPosDeviation:=VS_DEVIATION \MaxSpeedDeviation:=VS_SPEED;
        ELSE
            EGMSetupUC ROB_1, vsEgm, "default", "vibrostage" \Joint \CommTimeout:=VS_COMM_TIMEOUT;
            EGMActJoint vsEgm \StreamStart
                \J1:=VS_WINDOW \J2:=VS_WINDOW \J3:=VS_WINDOW \J4:=VS_WINDOW \J5:=VS_WINDOW \J6:=VS_WINDOW
                \LpFilter:=VS_FILTER \SampleRate:=4 \MaxPosDeviation:=VS_DEVIATION \MaxSpeedDeviation:=VS_SPEED;
        ENDIF
    ENDPROC

    ! Follow once that is asked for, until nobody leads any more, or RESET.
    PROC VsGuide()
        WHILE NOT vsBegin DO
            VsServe;
        ENDWHILE
        vsBegin := FALSE;
        IF vsPose THEN
            EGMRunPose vsEgm, EGM_STOP_HOLD \NoWaitCond \X \Y \Z \Rx \Ry \Rz
                \CondTime:=VS_FOR \RampInTime:=VS_RAMP_IN \RampOutTime:=VS_RAMP_OUT \PosCorrGain:=1;
        ELSE
            EGMRunJoint vsEgm, EGM_STOP_HOLD \NoWaitCond \J1 \J2 \J3 \J4 \J5 \J6
                \CondTime:=VS_FOR \RampInTime:=VS_RAMP_IN \RampOutTime:=VS_RAMP_OUT \PosCorrGain:=1;
        ENDIF
        WHILE EGMGetState(vsEgm) = EGM_STATE_RUNNING AND NOT vsBegin DO
            VsServe;
        ENDWHILE
        IF EGMGetState(vsEgm) = EGM_STATE_RUNNING THEN
            EGMStop vsEgm, EGM_STOP_HOLD \RampOutTime:=VS_RAMP_OUT;
        ELSE
            TPWrite "vibrostage: guided motion is STOPPED, nobody leads";
        ENDIF
    ERROR
        IF ERRNO = ERR_UDPUC_COMM THEN
            ! no answer for VS_COMM_TIMEOUT: stand still, go on reporting, wait for RESET
            TRYNEXT;
        ENDIF
    ENDPROC

    ! Do what the motion task has to do itself.
    PROC VsServe()
        IF vsAsked <> vsDone THEN
            TEST vsKind
            CASE VS_SOFT:
                SoftDeact \Ramp:=150;
                FOR i FROM 1 TO 6 DO
                    IF vsSoft{i} > 0 THEN
                        SoftAct i, 100 * vsSoft{i} \Ramp:=150;
                    ENDIF
                ENDFOR
            CASE VS_RESET:
                vsBegin := TRUE;
            ENDTEST
            vsDone := vsAsked;
        ENDIF
        WaitTime 0.02;
    ENDPROC
ENDMODULE
